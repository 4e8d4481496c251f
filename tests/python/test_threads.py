# SPDX-License-Identifier: Apache-2.0
"""Threads that begin to use the module together, and threads that still run when the program ends."""
import subprocess
import sys

FIRST_ARRAYS = """
import sys, threading
import cluxel
answer = cluxel.open(sys.argv[1]).query("SELECT ?n { ?s clx:pointCount ?n }")
threads = [threading.Thread(target=lambda: answer["n"]) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(answer["n"].dtype)
"""

LAST_QUERIES = """
import sys, threading, time
import cluxel
map = cluxel.open(sys.argv[1])
def ask():
    while True: map.query("ASK { ?s clx:height ?h }")
for _ in range(4): threading.Thread(target=ask, daemon=True).start()
time.sleep(0.1)
print("end")
"""


def outcome_of(program, campus):
    """Exit code and output of a Python program of its own."""
    done = subprocess.run([sys.executable, "-c", program, campus.file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=60)
    return done.returncode, done.stdout


def test_threads_may_read_their_first_arrays_together(campus):
    assert outcome_of(FIRST_ARRAYS, campus) == (0, "int64\n")


def test_a_thread_that_still_asks_does_not_abort_the_end_of_the_program(campus):
    assert [outcome_of(LAST_QUERIES, campus) for _ in range(5)] == [(0, "end\n")] * 5

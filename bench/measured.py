#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Runs a command and prints its processor time and elapsed time [s] and its largest anonymous memory [MB]: RssAnon of
# /proc/PID/status, read every 20 ms. Its output is dropped, or kept in a file; messages are shown when it fails.
# Usage: bench/measured.py [--output FILE] COMMAND [ARGUMENT...]
import os
import subprocess
import sys
import tempfile
import time


def anonymous_kb(pid):
    """RssAnon, or 0 when the process is gone."""
    try:
        with open(f"/proc/{pid}/status", encoding="ascii") as status:
            return next((int(line.split()[1]) for line in status if line.startswith("RssAnon")), 0)
    except OSError:
        return 0


def main():
    arguments, output = sys.argv[1:], os.devnull
    if arguments[:1] == ["--output"]:
        output, arguments = arguments[1], arguments[2:]
    if not arguments:
        sys.exit(next(line[2:].strip() for line in open(__file__, encoding="utf-8") if "Usage:" in line))
    start, peak_kb, done = time.monotonic(), 0, 0
    with open(output, "wb") as out, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(arguments, stdout=out, stderr=errors)
        while done == 0:
            peak_kb = max(peak_kb, anonymous_kb(process.pid))
            time.sleep(0.02)
            done, status, usage = os.wait4(process.pid, os.WNOHANG)
        code = os.waitstatus_to_exitcode(status)
        if code != 0:
            errors.seek(0)
            sys.stderr.write(errors.read().decode(errors="replace"))
    elapsed = time.monotonic() - start
    print(f"{usage.ru_utime + usage.ru_stime:.2f} {elapsed:.2f} {peak_kb * 1024 / 1e6:.0f}")
    sys.exit(code)


if __name__ == "__main__":
    main()

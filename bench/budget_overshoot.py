#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far hostile queries and updates go beyond a deadline and a memory budget.

usage: budget_overshoot.py PROGRAM STORE [NAME...]

STORE is a store of the million triples that `bench/store_bench.cpp` describes, for example by `cluxel load`. Each
question runs once with a deadline of 1 s and once with a budget of 256 MB. Printed are the time and the processor time
after the start-up, and the peak of anonymous memory beyond that of a small query. 1.20 means 20 % over.
"""
import os
import shutil
import subprocess
import sys
import tempfile
import time

DEADLINE_S, MEMORY_MB = 1.0, 256

FILTER = " || ".join(f"?o = {i}" for i in range(900_000))
VALUES = " ".join(f'("v{i}" {i})' for i in range(600_000))
DOUBLED = '"' + "x" * 1024 + '" AS ?t0) ' + " ".join(
    f"BIND(CONCAT(?t{i}, ?t{i}) AS ?t{i + 1})" for i in range(15))
DISTINCT = DOUBLED.replace("AS ?t0)", ") AS ?t0)", 1)
CROSS = "?a clx:height ?x . ?b clx:height ?y . ?c clx:height ?z"

QUERIES = {
    "filter of 10 MB": f"SELECT * {{ ?s clx:height ?o FILTER({FILTER}) }}",
    "VALUES of 10 MB": f"SELECT (COUNT(*) AS ?n) {{ VALUES (?v ?i) {{ {VALUES} }} ?s clx:rule ?v }}",
    "cross product, counted": f"SELECT (COUNT(*) AS ?n) {{ {CROSS} FILTER(?x + ?y > ?z + 100) }}",
    "cross product, rows": f"SELECT ?a ?b ?c {{ {CROSS} }}",
    "cross product, sorted": f"SELECT ?a ?b {{ {CROSS} }} ORDER BY ?y DESC(?x)",
    "cross product, distinct": f"SELECT DISTINCT ?x ?y ?z {{ {CROSS} }}",
    "cross product, grouped": f"SELECT ?x ?y (COUNT(*) AS ?n) {{ {CROSS} }} GROUP BY ?x ?y",
    "texts of 32 MB a row": f"SELECT (STRLEN(?t15) AS ?n) {{ ?s clx:height ?o BIND({DOUBLED} }}",
    "texts of 32 MB, kept": f"SELECT ?t15 {{ ?s clx:height ?o BIND({DOUBLED} }} ORDER BY ?t15",
    "different texts of 32 MB": f"SELECT (STRLEN(?t15) AS ?n) {{ ?s clx:height ?o BIND(CONCAT(STR(?s), {DISTINCT} }}",
    "GROUP_CONCAT of all": "SELECT (GROUP_CONCAT(CONCAT(STR(?s), STR(?p), STR(?o))) AS ?t) { ?s ?p ?o }",
    "path of all pairs": "SELECT (COUNT(*) AS ?n) { ?a clx:near+ ?b }",
    "path of all pairs, rows": "SELECT ?a ?b { ?a (clx:near|^clx:near)* ?b } ORDER BY ?b",
    "sort of a million rows": "SELECT * { ?s ?p ?o . ?s clx:rule ?r } ORDER BY STR(?o) CONCAT(STR(?s), ?r)",
    "output of a million rows": "SELECT * { ?s ?p ?o . ?s clx:near ?n }",
    "regular expressions": 'SELECT * { ?s clx:near ?o FILTER(REGEX(STR(?s), "(.*)*(.*)*z$")) }',
    "band join of all": "SELECT (COUNT(*) AS ?n) { ?a clx:x ?p . ?b clx:x ?q FILTER(ABS(?p - ?q) < 100) }",
    "packing of trees": "SELECT (COUNT(*) AS ?n) { ?a clx:x ?p ; clx:y ?v . ?b clx:x ?q ; clx:y ?w "
                        "FILTER(ABS(?p - ?q) < 0.0001 && ABS(?v - ?w) < 0.0001) }",
    "EXISTS of products": f"SELECT * {{ ?s clx:near ?o FILTER NOT EXISTS {{ {CROSS} FILTER(?x + ?y + ?z < 0) }} }}",
    "CONSTRUCT of a product": f"CONSTRUCT {{ ?a clx:near ?b . ?b clx:near ?c }} WHERE {{ {CROSS} }}",
}
UPDATES = {
    "INSERT of a product": f"INSERT {{ ?a clx:with ?b . ?b clx:with ?c }} WHERE {{ {CROSS} }}",
    "DELETE of all": "DELETE WHERE { ?s ?p ?o }",
    "DELETE and INSERT of all": "DELETE { ?s ?p ?o } INSERT { ?s ?p [] . ?o ?p ?s } WHERE { ?s ?p ?o FILTER(isIRI(?o)) }",
    "INSERT of long texts": f"INSERT {{ ?s clx:text ?t12 }} WHERE {{ ?s clx:height ?o BIND(CONCAT(STR(?s), {DISTINCT} }}",
}


def anonymous_kb(pid):
    try:
        with open(f"/proc/{pid}/status", encoding="utf-8") as status:
            return next((int(line.split()[1]) for line in status if line.startswith("RssAnon")), 0)
    except OSError:
        return 0


def measured(command):
    """Seconds, processor seconds, peak of anonymous memory in MB, exit code and message."""
    start, peak = time.monotonic(), 0
    with open(os.devnull, "wb") as null, tempfile.TemporaryFile() as messages:
        process = subprocess.Popen(command, stdout=null, stderr=messages)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            peak = max(peak, anonymous_kb(process.pid))
            if time.monotonic() - start > 120:
                process.kill()
            time.sleep(0.002)
        messages.seek(0)
        text = messages.read().decode(errors="replace").strip().splitlines()
    process.returncode = os.waitstatus_to_exitcode(status)
    return (time.monotonic() - start, usage.ru_utime + usage.ru_stime, peak / 1024, process.returncode,
            text[-1][:60] if text else "")


def main():
    program, store, *names = sys.argv[1:]
    folder = tempfile.mkdtemp()
    text, copy = os.path.join(folder, "q.rq"), os.path.join(folder, "copy.clx")

    def run(kind, question, *options):
        with open(text, "w", encoding="utf-8") as file:
            file.write(question)
        target = store
        if kind == "update":
            shutil.copyfile(store, copy)
            target = copy
        return measured([program, kind, target, text, *options])

    bases = {"query": run("query", "ASK { clx:none ?p ?o }"),
             "update": run("update", "INSERT DATA { GRAPH <http://x/other> { clx:none clx:p 1 } }", "--strict")}
    for kind, base in bases.items():
        print(f"start-up of a small {kind}: {base[0]:.2f} s, {base[1]:.2f} s processor, {base[2]:.0f} MB")
    print("| question | deadline: elapsed | processor | end | memory: peak | end |")
    print("|---|---|---|---|---|---|")
    for kind, questions in (("query", QUERIES), ("update", UPDATES)):
        base = bases[kind]
        for name, question in questions.items():
            if names and not any(wanted in name for wanted in names):
                continue
            late = run(kind, question, "--deadline", str(DEADLINE_S))
            large = run(kind, question, "--max-memory", str(MEMORY_MB), "--deadline", "20")
            print(f"| {name} | {(late[0] - base[0]) / DEADLINE_S:.2f} | {(late[1] - base[1]) / DEADLINE_S:.2f} | "
                  f"{late[3]} | {(large[2] - base[2]) / MEMORY_MB:.2f} | {large[3]} |", flush=True)
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()

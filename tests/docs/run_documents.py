#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Runs what the documents print: every command of a ```console block, in order, in a scratch folder, and compares the
# output with the lines shown below it. Usage:
#   run_documents.py [--first] --source CHECKOUT --program FOLDER DOCUMENT.md ...
# --first: only the first block of each document that runs commands; it needs no checkout.
#
#   ```console
#   $ cluxel query campus.clx street_signs.rq      a command; it must exit with 0
#   sign   x   y                                   expected output, compared word by word
#   ...                                            any number of other lines
#   ```
# Commands outside of console blocks are not run. Marks in the line before a block, as HTML comments:
#   <!-- not run: REASON -->        the block is shown only; REASON must be given
#   <!-- folder: checkout -->       the block runs at the top of the checkout, not in the scratch folder
#   <!-- file: PATH -->             a block of any language; it must be the text of PATH in the checkout
#   <!-- file: PATH part -->        it must stand in PATH, line by line
#   <!-- write: NAME -->            the block is written to NAME in the scratch folder
#   <!-- patch: PATH -> NAME -->    a diff block: applied to PATH of the checkout, the result is NAME in the scratch folder
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MARK = re.compile(r"<!-- (not run|file|write|patch|folder): (.*?) -->")


def blocks_of(text):
    """(line number, language, mark, lines) of each fenced block."""
    lines, found, number = text.split("\n"), [], 0
    while number < len(lines):
        fence = re.match(r"\s*```(\w*)\s*$", lines[number])
        if fence:
            end = next(i for i in range(number + 1, len(lines)) if lines[i].strip() == "```")
            mark = next((MARK.search(line) for line in reversed(lines[:number]) if line.strip()), None)
            found.append((number + 1, fence[1], mark.groups() if mark else None, lines[number + 1 : end]))
            number = end
        number += 1
    return found


def commands_of(lines):
    """(command, expected lines) of each `$ ` line; a backslash at the end or an open quote continues a command."""
    commands = []
    for line in lines:
        if commands and not commands[-1][1] and (commands[-1][0].endswith("\\") or commands[-1][0].count("'") % 2):
            commands[-1][0] += "\n" + line
        elif line.startswith("$ "):
            commands.append([line[2:], []])
        elif commands:
            commands[-1][1].append(line)
    return commands


def matches(expected, actual):
    """True when the expected lines stand in the actual ones; `...` stands for any lines; spaces count as one."""
    words = [" ".join(line.split()) for line in actual if line.strip()]
    position, may_skip = 0, False
    for line in (" ".join(line.split()) for line in expected if line.strip()):
        if line == "...":
            may_skip = True
            continue
        pattern = re.compile(re.escape(line).replace(re.escape("…"), ".*") + "$")
        end = len(words) if may_skip else position + 1
        hit = next((i for i in range(position, min(end, len(words))) if pattern.match(words[i])), None)
        if hit is None:
            return f"no line '{line}'"
        position, may_skip = hit + 1, False
    return None if may_skip or position == len(words) or not expected else f"more output: '{words[position]}'"


class Runner:
    def __init__(self, source, program, folder):
        self.source, self.folder = source, folder
        path = f"{program}:{pathlib.Path(sys.executable).parent}:{os.environ['PATH']}"
        self.environment = dict(os.environ, PATH=path, SOURCE=str(source), COLUMNS="160", PYTHONPATH=f"{program}/python")
        self.environment.pop("CLUXEL_HOME", None)
        self.commands, self.faults = 0, []

    def fault(self, place, text):
        self.faults.append(f"{place}: {text}")

    def run(self, place, command, expected, folder):
        done = subprocess.run(["bash", "-c", command], cwd=folder, env=self.environment, capture_output=True, text=True)
        self.commands += 1
        if done.returncode != 0:
            self.fault(place, f"'{command}' exits with {done.returncode}: {done.stderr.strip()[-800:]}")
        elif expected:
            difference = matches(expected, done.stdout.split("\n"))
            if difference:
                self.fault(place, f"'{command}': {difference}; it printed:\n{done.stdout[:1500]}")

    def block(self, place, language, mark, lines):
        kind, value = mark or (None, None)
        text = "\n".join(lines) + "\n"
        if kind == "not run":
            return
        if kind == "file":
            path, _, part = value.partition(" ")
            whole = (self.source / path).read_text() if (self.source / path).is_file() else ""
            if text not in whole if part == "part" else text != whole:
                self.fault(place, f"is not the text of {path}")
        elif kind == "write":
            (self.folder / value).write_text(text)
        elif kind == "patch":
            path, _, name = value.partition(" -> ")
            done = subprocess.run(["patch", "-s", "-o", str(self.folder / name), str(self.source / path)], input=with_header(text), capture_output=True, text=True)
            if done.returncode != 0:
                self.fault(place, f"does not apply to {path}: {done.stdout}{done.stderr}")
        elif language == "diff":
            self.fault(place, "a diff needs a mark that says what it is applied to")
        elif language == "console":
            for command, expected in commands_of(lines):
                self.run(place, command, expected, self.source if kind == "folder" else self.folder)


def with_header(text):
    """A hunk header for a diff that shows only changed lines and their neighbours."""
    if "@@" in text:
        return text
    old = sum(line[:1] in "- " for line in text.split("\n")[:-1])
    new = sum(line[:1] in "+ " for line in text.split("\n")[:-1])
    return f"--- a\n+++ b\n@@ -1,{old} +1,{new} @@\n{text}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--first", action="store_true")
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("documents", type=pathlib.Path, nargs="+")
    args = parser.parse_args()
    faults = []
    for document in args.documents:
        with tempfile.TemporaryDirectory() as folder:
            runner = Runner(args.source.resolve(), args.program.resolve(), pathlib.Path(folder))
            for line, language, mark, lines in blocks_of(document.read_text()):
                if not args.first or (language == "console" and mark is None and runner.commands == 0):
                    runner.block(f"{document}:{line}", language, mark, lines)
            print(f"{document}: {runner.commands} commands run, {len(runner.faults)} faults")
            faults += runner.faults
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

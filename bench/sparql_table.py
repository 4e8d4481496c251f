# SPDX-License-Identifier: Apache-2.0
# What `./run bench sparql` printed (standard input), as the one table of docs/sparql.md; or, from a run without peers, that
# document (its name as argument) with the columns of growth put anew.
import re
import sys


def blocks(lines):
    """Tables with the heading of each: lists of rows of cells."""
    table = None
    for line in lines:
        if line.startswith("| question"):
            table = (line, [])
            yield table
        elif line.startswith("|") and table and "---" not in line:
            table[1].append([cell.strip() for cell in line.strip().strip("|").split("|")])
        elif not line.startswith("|"):
            table = None


def growth_cells(grown):
    return [grown[2], f"{grown[3]} ({grown[4]}, {grown[5]})" + (" over" if "over" in grown[6] else "")]


def put_growth_into(document, growth):
    """The columns "10M: ours" and "time ×" of the table in the document."""
    with open(document, encoding="utf-8") as file:
        lines = file.read().splitlines()
    heading = next(line for line in lines if line.startswith("| question") and "10M: ours" in line)
    at = [cell.strip() for cell in heading.strip().strip("|").split("|")].index("10M: ours")
    for i in range(lines.index(heading) + 2, len(lines)):
        if not lines[i].startswith("|"):
            break
        cells = [cell.strip() for cell in lines[i].strip().strip("|").split("|")]
        cells[at:at + 2] = growth_cells(growth[cells[0]])
        lines[i] = "| " + " | ".join(cells) + " |"
    print("\n".join(lines))


def main():
    tables = list(blocks(sys.stdin.read().splitlines()))
    rasqal = {row[0]: row for heading, rows in tables if "rasqal" in heading for row in rows}
    peers = [{row[0]: row for row in rows} for heading, rows in tables if "oxigraph" in heading]
    growth = {row[0]: row for heading, rows in tables if "time grows" in heading for row in rows}
    if len(sys.argv) > 1:
        put_growth_into(sys.argv[1], growth)
        return
    small, large = peers[0], peers[1]
    for name, row in large.items():
        grown, first = growth.get(name), rasqal.get(name)
        cells = [name, row[1], *small[name][2:5], *row[2:5]]
        cells += growth_cells(grown) if grown else ["", ""]
        wrong = re.search(r"rasqal (\d+)", first[1]) if first else None
        cells += [first[2], first[3] + (f" (wrong: {wrong.group(1)} lines)" if wrong else "")] if first else ["", ""]
        print("| " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()

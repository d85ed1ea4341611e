#!/usr/bin/env python3
"""Lines of C++ per module without blank lines and comments. Usage: scripts/size.py [--files] [COMMIT]

Scripts, styles and texts of pages, .js, .css, R"js(...)js" and the like, are the row "scripts". Sources are formatted by
scripts/format.sh first; then a module cannot shrink by dense code. "product" is the total without tests and scripts.
With COMMIT that of the commit stands beside; --files lists the largest files of each module.
"""
import re
import subprocess
import sys

MODULES = ["core", "ingest", "fitting", "canon", "train", "eval", "report", "app", "job", "scripts", "tests"]


def git(*arguments):
    return subprocess.run(["git", *arguments], capture_output=True, check=True).stdout.decode("utf-8", "replace")


SCRIPT = re.compile(r'R"(js|css|html)\((.*?)\)\1"', re.S)


def script_lines(text):
    return sum(1 for match in SCRIPT.finditer(text) for line in match.group(2).split("\n") if line.strip())


def code_lines(text):
    """Counts lines that hold more than comments; texts in quotes may hold what looks like one."""
    text = SCRIPT.sub('""', text)
    text = re.sub(r'("(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\')|//[^\n]*|/\*.*?\*/',
                  lambda m: m.group(1) or "\n" * m.group(0).count("\n"), text, flags=re.S)
    return sum(1 for line in text.split("\n") if line.strip())


def sizes(commit):
    names = git("ls-tree", "-r", "--name-only", commit).split("\n") if commit else git("ls-files", "-co",
                                                                                      "--exclude-standard").split("\n")
    counted = {}
    for name in names:
        if not re.search(r"\.(cpp|h|js|css)$", name) or name.split("/")[0] not in MODULES:
            continue
        try:
            text = git("show", f"{commit}:{name}") if commit else open(name, encoding="utf-8").read()
        except FileNotFoundError:
            continue  # deleted, not yet committed
        if re.search(r"\.(js|css)$", name):
            counted["scripts/" + name] = code_lines(text)
            continue
        counted[name] = code_lines(text)
        if (scripts := script_lines(text)) and name.split("/")[0] != "tests":
            counted["scripts/" + name] = scripts
    return counted


def main():
    arguments = [a for a in sys.argv[1:] if a != "--files"]
    now = sizes(None)
    before = sizes(arguments[0]) if arguments else {}
    line = lambda name, total, then: f"{name:8} {total:7}" + (f" {then:7} {total - then:+7}" if before else "")
    product = [0, 0]
    for module in MODULES:
        own = {n: c for n, c in now.items() if n.split("/")[0] == module}
        then = sum(c for n, c in before.items() if n.split("/")[0] == module)
        total = sum(own.values())
        if module == "scripts":
            print(line("product", *product))
        product = [product[0] + total, product[1] + then]
        if total or then:
            print(line(module, total, then))
        if "--files" in sys.argv:
            for name, count in sorted(own.items(), key=lambda item: -item[1])[:12]:
                print(f"         {count:5} {name}")


main()

"""Adds up the JUnit files of a test run and prints `N passed, N failed`; exit code 1 unless all passed.

A command that failed although none of its tests did (a crash, no results written) counts as one failure.
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree


def main(folder):
    passed, failed, skipped = 0, 0, 0
    names_of_failed = []
    for path in sorted(folder.rglob("*.xml")):
        # rostest writes one file for itself and one for each test in it: cases are counted once, by name.
        for case in ElementTree.parse(path).getroot().iter("testcase"):
            kinds = {child.tag for child in case}
            if kinds & {"failure", "error"}:
                failed += 1
                names_of_failed.append("%s: %s" % (path.relative_to(folder), case.get("name")))
            elif "skipped" in kinds or case.get("status") == "notrun":
                skipped += 1
            else:
                passed += 1
    commands = folder / "failed_commands"
    for line in commands.read_text().splitlines() if commands.exists() else []:
        code, name = line.split(" ", 1)
        if not any(entry.startswith((name + ".", "rostest/" + name + "/")) for entry in names_of_failed):
            failed += 1
            names_of_failed.append("%s: ended with exit code %s" % (name, code))
    for name in names_of_failed:
        print("failed: " + name)
    if passed + failed == 0:
        print("test: no test ran", file=sys.stderr)
        return 1
    print("%d passed, %d failed%s" % (passed, failed, ", %d skipped" % skipped if skipped else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))

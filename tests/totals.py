"""Adds up the JUnit files of a test run and prints `N passed, N failed`; exit code 1 unless all passed.

A command that failed although none of its tests did (a crash, no results written) counts as one failure, and so does
a file that cannot be read or holds no test: rostest calls it a success.
"""
import pathlib
import sys
import xml.etree.ElementTree as ElementTree


def cases_of(path):
    """Test cases of a JUnit file, none if it is not one."""
    try:
        return list(ElementTree.parse(path).getroot().iter("testcase"))
    except ElementTree.ParseError:
        return []


def main(folder):
    passed, failed, skipped = 0, 0, 0
    names_of_failed = []
    for path in sorted(folder.rglob("*.xml")):
        # rostest writes one file for itself, a case for each program it started, and one for each program's tests.
        cases = cases_of(path)
        if not cases:
            failed += 1
            names_of_failed.append("%s: no test in it" % path.relative_to(folder))
        for case in cases:
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

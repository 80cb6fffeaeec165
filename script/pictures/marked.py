"""Parts of a page between two marks, each on a line of its own: tables that a program writes and tests read."""


def parts(page, begin, end):
    """(before, block, after) of a page; the marks stay outside the block. SystemExit: a mark is not there."""
    before, found, rest = page.partition(begin)
    block, ended, after = rest.partition(end)
    if not (found and ended):
        raise SystemExit(f"found no '{begin.strip()}' ... '{end}' in the page")
    return before + found, block, ended + after


def replaced(page, begin, end, block):
    """The page with another block between the marks."""
    before, _, after = parts(page, begin, end)
    return before + block + after

"""XML that Gazebo's reader takes and expat refuses."""
import re
import xml.etree.ElementTree as ElementTree

PREFIX = re.compile(r"(</?|\s)(?!xml)([\w.-]+):(?=[\w.-]+[\s=/>])")
DECLARATION = re.compile(r"<\?xml\s.*?\?>", re.DOTALL)
COMMENT = re.compile(r"(<!\[CDATA\[.*?\]\]>)|<!--.*?-->", re.DOTALL)
AMPERSAND = re.compile(r"(<!\[CDATA\[.*?\]\]>)|&(?!#\d+;|#x[\da-fA-F]+;|(?:amp|lt|gt|quot|apos);)", re.DOTALL)


def parsed(text: str) -> ElementTree.Element:
    """Returns the root of a document, as far as readable() can mend it.

    Raises: ElementTree.ParseError, ValueError: no XML.
    """
    return ElementTree.fromstring(readable(text))


def readable(text: str) -> str:
    """Returns a document that expat reads, with the same lines. As Gazebo's reader does, it takes `--` in comments, a
    plain `&`, prefixes of names that nothing declares, which become a part of the names, a declaration that is not the
    first thing in it, and zero bytes at its end.

    Raises: ElementTree.ParseError, ValueError: no XML.
    """
    text = text.rstrip("\0")
    for repair in REPAIRS:
        try:
            ElementTree.fromstring(text)
        except ElementTree.ParseError:
            text = repair(text)
        else:
            return text
    ElementTree.fromstring(text)
    return text


def without_comments(text: str) -> str:
    """Returns a document without comments, and with `&amp;` for a `&` that begins no entity."""
    text = COMMENT.sub(lambda found: found[1] or "\n" * found[0].count("\n"), text)
    return AMPERSAND.sub(lambda found: found[1] or "&amp;", text)


def without_prefixes(text: str) -> str:
    """Returns a document without declaration, and with `a_b` for each name `a:b`."""
    return PREFIX.sub(r"\1\2_", DECLARATION.sub("", text))


REPAIRS = without_comments, without_prefixes  #: of documents that expat rejects and Gazebo's reader accepts

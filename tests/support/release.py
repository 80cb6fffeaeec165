"""The release of Debian that the tests run on."""
import pathlib
import re

import pytest

RELEASE = re.search(r'^VERSION_ID="?(\d+)', pathlib.Path("/etc/os-release").read_text(), re.MULTILINE)[1]
#: numpy and scipy draw other starts on other releases, and another Mesa draws other images.
of_debian_12 = pytest.mark.skipif(RELEASE != "12", reason="the page states the figures of Debian 12")

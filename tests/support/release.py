"""The release of Debian that the tests run on."""
import platform

import pytest

RELEASE = platform.freedesktop_os_release()["VERSION_ID"]
#: numpy and scipy draw other starts on other releases, and another Mesa draws other images.
of_debian_12 = pytest.mark.skipif(RELEASE != "12", reason="the page states the figures of Debian 12")

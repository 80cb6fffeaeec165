"""Pages from the templates of config/templates, all made by one Jinja environment."""

import functools

from ..config.files import share_dir


def render(template, /, **values):
    """The page of config/templates/TEMPLATE with these values, str; a name in it that nobody gives is an error."""
    return _environment().get_template(template).render(**values)


def source(name):
    """Text of a file of config/templates as it stands there, for example a script."""
    environment = _environment()
    return environment.loader.get_source(environment, name)[0]


@functools.lru_cache(maxsize=None)
def _environment():
    import jinja2  # slow to import
    return jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined,
                              loader=jinja2.FileSystemLoader(str(share_dir() / "config" / "templates")))

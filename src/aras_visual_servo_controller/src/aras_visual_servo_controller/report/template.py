"""Pages from the templates of config/."""

from ..config.files import share_dir


def render(template, /, **values):
    """The page of config/TEMPLATE with these values, str; what the template names and nobody gives is an error."""
    import jinja2  # slow to import
    environment = jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True,
                                     undefined=jinja2.StrictUndefined,
                                     loader=jinja2.FileSystemLoader(str(share_dir() / "config")))
    return environment.get_template(template).render(**values)

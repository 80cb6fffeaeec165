"""Makes figures, pages, videos and tables of a run."""

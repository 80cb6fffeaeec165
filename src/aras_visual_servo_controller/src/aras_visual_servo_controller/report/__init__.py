"""What a run is shown as: figures, pages, videos and tables."""

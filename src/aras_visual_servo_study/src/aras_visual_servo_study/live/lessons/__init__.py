"""The lessons of the live page, one a file. `live/lesson.py` says what a lesson is."""

"""EMVA Standard 1288, Release 4.0 Linear: a camera's data sheet from its recording."""

"""Result files: one writer, checksums, and the files of several tables."""

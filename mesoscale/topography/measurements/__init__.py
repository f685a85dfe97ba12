"""What instruments measured: files and their formats, levelling, and what each instrument can see."""

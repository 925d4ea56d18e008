"""The neutral program, its checks before it is written, and one folder for each dialect."""

"""The peers: one file each, every one a plain use of what it is named after."""

"""One question asked at many targets: tasks, cells, running, storage, answers."""

"""The local app: a page on the user's own machine that shows the planner's answers and takes the user's wishes.

Nothing in here computes: it calls what the command line calls. `state` is what a page shows, one small immutable value;
`session` holds it and tells the views of every change; `views` are functions of it.
"""

import os

for _name in ("NICEGUI_REDIS_URL", "FASTAPI_OTEL_AUTO_CONFIGURE"):
    os.environ.pop(_name, None)  # what the page is served with would take it as an order to talk to other machines

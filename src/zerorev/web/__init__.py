"""The local app: a page on the user's own machine that shows the planner's answers and takes the user's wishes.

Nothing in here computes: it calls what the command line calls. `state` is what a page shows, one small immutable value;
`session` holds it and tells the views of every change; `views` are functions of it.
"""

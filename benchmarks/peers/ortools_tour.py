"""OR-Tools' routing (Google): an open tour through holes whose motions are given, by guided local search."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

__all__ = ["tour"]

UNITS = 1e6  # OR-Tools counts in whole numbers


def tour(cost: npt.NDArray[np.float64], seconds: int) -> list[int]:
    """An order in which all are visited once.

    Args:
        cost: from each to each, shape (N, N); it need not be symmetric.
        seconds: how long to search.
    """
    count = len(cost)
    whole = np.zeros((count + 1, count + 1), dtype=np.int64)  # the last one is where the tour begins and ends, free
    whole[:count, :count] = np.round(cost * UNITS)
    manager = pywrapcp.RoutingIndexManager(count + 1, 1, count)
    routing = pywrapcp.RoutingModel(manager)
    rows = whole.tolist()

    def between(start: int, end: int) -> int:
        return int(rows[manager.IndexToNode(start)][manager.IndexToNode(end)])

    routing.SetArcCostEvaluatorOfAllVehicles(routing.RegisterTransitCallback(between))
    asked = pywrapcp.DefaultRoutingSearchParameters()
    asked.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    asked.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    asked.time_limit.FromSeconds(seconds)
    found = routing.SolveWithParameters(asked)
    at, order = routing.Start(0), []
    while not routing.IsEnd(at):
        order.append(manager.IndexToNode(at))
        at = found.Value(routing.NextVar(at))
    return order[1:]

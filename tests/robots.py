"""The robots that whole suites run through: of each maker and shape one or more, with all that files can say of an arm.

The others that ship are numbers alone; `tests/files/test_catalogue.py` goes through all of them.
"""

TRIED = [
    "abb_irb1200_5_90", "abb_irb4600_60_205", "abb_irb6640_185_280", "fanuc_lrmate200id", "fanuc_m710ic_50",
    "fanuc_r2000ic_165f", "kuka_kr120_r2700_2", "kuka_kr6_r700_2", "staubli_tx2_90l", "yaskawa_gp25", "yaskawa_gp8",
    "yaskawa_ma2010",
]  # fmt: skip

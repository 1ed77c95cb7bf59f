import sys; sys.exit("report.py is being written")

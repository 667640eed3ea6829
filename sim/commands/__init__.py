"""The commands of ``nephroid``, one a module.

Each has a ``SUMMARY`` of one line, ``add_arguments(parser)`` and ``run(arguments)``; its docstring
is its help. At import they load nothing but the standard library's light parts.
"""

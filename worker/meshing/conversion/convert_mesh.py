"""Reads a mesh of any format and writes what palpate reads: run by `palpate mesh` (mesh_conversion.hpp).

    python3 convert_mesh.py INPUT OUTPUT [--straight] [--weld]

A mesh with tetrahedra becomes Gmsh's format 2.2, ASCII, with its groups; one of triangles alone the bytes that
closed_surface.cpp reads: two int64 (points, triangles), the points as float64, the triangles as int32. The first line
of stdout says which, "volume" or "surface"; each further line is a note for people. Exit 2 and one sentence on stderr
where the input is wrong, 3 and the name of a Python module where that is missing
(of numpy as `palpate mesh` runs it).

Formats with a reader here: those of which meshio loses groups (.inp, binary .msh), or that it does not know (.feb,
TetGen of ten nodes), and plain surfaces, whose errors then name the line. Everything else is read by meshio.
"""
import errno
import pathlib
import sys

from abaqus_file import read_abaqus
from body import Wrong, wrong
from checks import check_points, put_middles_right, refuse_other_volumes, weld
from febio_file import read_febio
from gmsh_file import read_gmsh
from meshio_file import read_by_meshio
from medit_file import read_medit
from surface_files import read_obj, read_off, read_ply, read_stl
from tetgen_files import read_tetgen
from vtk_file import read_vtk
from vtu_file import read_vtu
from written_mesh import triangles_of, write_surface, write_volume

READERS = {".stl": read_stl, ".obj": read_obj, ".off": read_off, ".ply": read_ply, ".node": read_tetgen,
           ".ele": read_tetgen, ".inp": read_abaqus, ".feb": read_febio, ".msh": read_gmsh,
           ".vtk": read_vtk, ".vtu": read_vtu, ".vtp": read_vtu, ".mesh": read_medit}


class Unwritable(Exception):
    """Why the output could not be written."""


def convert(source, output, straight, welded):
    """"volume" or "surface", and notes."""
    path = pathlib.Path(source)
    try:
        body = READERS.get(path.suffix.lower(), read_by_meshio)(path)
    except (ArithmeticError, LookupError, ValueError) as error:
        wrong(source, None, f"it is truncated, or not of the format that its ending says ({error!r}); save it again, "
                            "or in another format")
    check_points(body, source)
    refuse_other_volumes(body, source)
    is_volume = any(kind.startswith("tetra") and len(cells) for kind, cells in body.blocks)
    if is_volume:
        put_middles_right(body, source, straight)
        if welded:
            weld(body)
    triangles = triangles_of(body)
    if not is_volume and not len(triangles):
        wrong(source, None, "there are neither tetrahedra nor triangles in it")
    try:
        if is_volume:
            write_volume(body, output)
        else:
            write_surface(body, triangles, output)
    except OSError as error:
        more = "; make room, or set TMPDIR to another folder" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
        raise Unwritable(f"{output}: cannot be written: {error.strerror or error}{more}") from None
    return ["volume" if is_volume else "surface", *body.notes]


def main(arguments):
    source, output, *flags = arguments
    try:
        print("\n".join(convert(source, output, "--straight" in flags, "--weld" in flags)))
    except Wrong as what:
        print(str(what).replace("\n", "?"), file=sys.stderr)  # one line, whatever the name of the file
        return 2
    except Unwritable as why:
        print(why, file=sys.stderr)
        return 1
    except ModuleNotFoundError as missing:
        print(missing.name, file=sys.stderr)
        return 3
    except OSError as error:
        print(f"{error.filename or source}: {error.strerror or error}", file=sys.stderr)
        return 2
    except MemoryError:
        print(f"{source}: this machine has not enough memory for it", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""A compiled kernel: its body, for the kernels that call it, and its machine code, for Python.

Numba makes both at once, and a wrapper for C besides. But most kernels are called by other kernels alone, which take
the optimised body into their own; machine code of theirs would never run. So here a body is made when another kernel
asks for it, and machine code out of the body when Python calls.

What is made of a body does not depend on where it comes from: also in the process that compiles it, it is read back
from its bytes, as others read it from the cache. And everything that is made calls its own copies of the kernels that
it calls. Numba compiles what a kernel calls into it under the same name, and optimises each copy in its place, so that
they round differently; all copies of a name in a process would give way to the first.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import llvmlite.binding as llvm  # type: ignore[import-untyped]
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler import CompileResult, compile_result
from numba.core.cpu import CPUContext
from numba.core.runtime.nrt import rtsys

__all__ = ["body_of", "called", "read_body", "read_called", "written_body", "written_called"]

# what is used of Numba that it need not have
_NEEDED = (
    CPUCodeLibrary._finalize_final_module,
    CPUCodeLibrary._finalize_dynamic_globals,
    CPUCodeLibrary._verify_declare_only_symbols,
    CPUCodeLibrary._get_module_for_linking,
    CompileResult._find_referenced_environments,
    CPUContext.create_cpython_wrapper,
    CPUContext.get_executable,
)


def body_of(compiled: Any) -> Any:
    """The body of a kernel that was typed and translated: optimised with all that it calls, and ready to be linked.

    Args:
        compiled: what Numba's compiler gives back where it is to make neither a wrapper nor machine code.
    """
    library = compiled.library
    library._finalize_final_module = partial(_finished, library)
    library.finalize()
    return _with_environments(compiled)._replace(entry_point=object())  # by which the target knows it


def _finished(library: Any) -> None:
    """The end of a library that is only to be linked: the rest of what Numba would do makes machine code."""
    library._finalize_dynamic_globals()
    library._verify_declare_only_symbols()
    for function in library._final_module.functions:
        if not function.is_declaration and function.linkage.name == "external":
            function.linkage = "linkonce_odr"
    library._bytes = library._final_module.as_bitcode()
    library._shared_module = llvm.parse_bitcode(library._bytes)
    library._finalized = True


def called(body: Any, counted: bool) -> Any:
    """What Python calls: the machine code of a body, and a wrapper that takes its arguments out of Python's objects.

    Args:
        body: of `body_of` or `read_body`.
        counted: whether holders of arrays are counted.
    """
    body.target_context.refresh()  # a body that was read may be all that this process has asked of the compiler
    context, fndesc = body.target_context.subtarget(enable_nrt=counted), body.fndesc
    library = context.codegen().create_library(body.library.name)
    library.enable_object_caching()
    with context.push_code_library(library):
        context.create_cpython_wrapper(library, fndesc, body.environment, None, release_gil=True)
    library.add_linking_library(rtsys.library)
    library._finalize_final_module = partial(_joined, library, body.library._bytes, fndesc.llvm_func_name)
    library.finalize()
    return _ready(body, library)


def _joined(library: Any, body: bytes, name: str) -> None:
    """Join an optimised wrapper and an optimised body, and make machine code of both."""
    module = library._final_module
    module.link_in(llvm.parse_bitcode(body), preserve=True)
    for function in module.functions:
        if not function.is_declaration and function.linkage.name == "linkonce_odr":
            function.linkage = "external" if function.name == name else "internal"
    CPUCodeLibrary._finalize_final_module(library)  # type: ignore[no-untyped-call]


def _ready(body: Any, library: Any) -> Any:
    """Find the machine code, and put in place what it takes from Python: the constants of error messages."""
    context = body.target_context
    cfunc = context.get_executable(library, body.fndesc, body.environment)
    for environment in body.referenced_envs:
        library.codegen.set_env(environment.env_name, environment)
    return body._replace(library=library, entry_point=cfunc)


def _with_environments(compiled: Any) -> Any:
    return compiled._replace(referenced_envs=tuple(compiled._find_referenced_environments()))


def written_body(compiled: Any) -> tuple[Any, ...]:
    """A body as it is kept; Numba hands over what it has compiled, of which `body_of` was made meanwhile."""
    return compiled.library._bytes, *_kept(_with_environments(compiled))


def written_called(made: Any) -> tuple[Any, ...]:
    """Machine code as it is kept."""
    return made.library._get_compiled_object(), *_kept(made)


def _kept(compiled: Any) -> tuple[Any, ...]:
    compiled.fndesc.typemap = compiled.fndesc.calltypes = None  # of use to the translation alone
    return (
        compiled.library.name, compiled.fndesc, compiled.environment, tuple(compiled.environment.consts),
        compiled.signature, compiled.reload_init, compiled.referenced_envs,
    )  # fmt: skip


def read_body(context: Any, kept: tuple[Any, ...]) -> Any:
    """A body that was kept."""
    held, *rest = kept
    read = _read(context, *rest)
    library = read.library
    library._bytes = held
    library._shared_module = llvm.parse_bitcode(held)
    library._finalized = True
    return read._replace(entry_point=object())


def read_called(context: Any, kept: tuple[Any, ...]) -> Any:
    """Machine code that was kept; the compiler has no part in it."""
    held, *rest = kept
    read = _read(context, *rest)
    library = read.library
    library.enable_object_caching()
    library._set_compiled_object(held)
    library._finalize_final_module()
    library.codegen._engine._defined_symbols.add(read.fndesc.llvm_cpython_wrapper_name)
    return _ready(read, library)


def _read(
    context: Any,
    name: str,
    fndesc: Any,
    environment: Any,
    constants: tuple[Any, ...],
    signature: Any,
    reload_init: Any,
    referenced_envs: Any,
) -> Any:
    for each in reload_init or ():
        each()
    # an environment that came with another kernel has the constants of the body alone; those of a wrapper come behind
    if len(environment.consts) < len(constants):
        environment.consts[:] = constants
    return compile_result(  # type: ignore[no-untyped-call]
        typing_context=context.typing_context, target_context=context, library=context.codegen().create_library(name),
        environment=environment, fndesc=fndesc, signature=signature, objectmode=False, lifted=(),
        reload_init=reload_init, referenced_envs=referenced_envs,
    )  # fmt: skip

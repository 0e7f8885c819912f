"""Names in C: those of the source, with the module's before them only where two clash."""

from __future__ import annotations

from collections.abc import Sequence

from .subset import ARGUMENTS

_KEYWORDS = """
auto break case char const continue default do double else enum extern float for goto if
inline int long register restrict return short signed sizeof static struct switch typedef
union unsigned void volatile while bool true false asm near far small interface
"""
KEYWORDS = frozenset(_KEYWORDS.split())

_LIBRARY = """
abs acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh div erf erfc exp exp2
expm1 fabs fdim floor fma fmax fmin fmod frexp gamma hypot ilogb index isfinite isinf isnan
isnormal j0 j1 jn labs ldexp lgamma llrint log log10 log1p log2 logb lrint lround modf nan
nearbyint nextafter pow remainder rindex rint round scalb scalbn signbit signgam sin sinh sqrt
tan tanh tgamma trunc y0 y1 yn free malloc calloc realloc exit abort system random signal time
clock read write open close link main stat printf puts NAN INFINITY HUGE_VAL NULL EOF int64_t
int32_t memcpy memset strlen setjmp longjmp jmp_buf isgreater isless M_PI PLAIN BOUNDED
GROWING
"""
LIBRARY = frozenset(_LIBRARY.split())
"""Names of the C library that a file sees, or that a linker may find in its place."""

_OWN = """
Fault Row Table PI INTERNAL NO_RETURN RARE MARK RETURN MOST_WHOLE fail fault within quotient
smaller larger whole_smaller whole_larger row_of entry_of remainder_of floored_of
whole_remainder whole_floored whole_of finite_of fabs copysign DOMAIN_ERROR RANGE_ERROR
ZERO_DIVISION ZERO_FLOOR ZERO_MODULO ZERO_WHOLE_FLOOR ZERO_WHOLE_MODULO OUT_OF_RANGE
INFINITE_TO_WHOLE NAN_TO_WHOLE NAN HUGE_VAL
"""
OWN = frozenset(_OWN.split()) | {f"{name}_of" for name in ARGUMENTS}
"""Names of `semantics.h`, and of the library's that translated physics uses itself."""

RESERVED = KEYWORDS | LIBRARY | OWN


class Names:
    """The names of one file, each given once."""

    def __init__(self) -> None:
        self._taken: dict[str, object] = {}

    def given(self, owner: object, name: str, modules: Sequence[str]) -> str:
        """A name for something: its own, or with one module's name after another before it."""
        made = name
        for module in (*modules, "other", "another"):
            if made not in RESERVED and self._taken.setdefault(made, owner) == owner:
                return made
            made = f"{module}_{name}"
        return made


def local(name: str, taken: frozenset[str]) -> str:
    """Name of a variable or a field: an underscore is added where C has another use for it."""
    while name in KEYWORDS or name in taken:
        name += "_"
    return name

"""The instructions of the core's stack machine. `src/core/machine/opcode.hpp` mirrors the numbers.

A word is a signed 32-bit integer; an instruction is an opcode followed by its operands. Values on the stack are 64-bit;
the result of every arithmetic instruction is taken modulo 2**32, as a signed 32-bit number.
"a b -- c" reads: pops b, pops a, pushes c.
"""

from __future__ import annotations

from enum import IntEnum


class Opcode(IntEnum):
    END = 0
    """End of a piece of code; its value, if it has one, is on top of the stack."""
    CONST = 1
    """CONST v: -- v"""
    LOAD = 2
    """LOAD slot: -- value"""
    LOAD_INDIRECT = 3
    """slot -- value"""
    STORE = 4
    """STORE slot: value -- ; checks the slot's range (error RANGE)"""
    STORE_INDIRECT = 5
    """slot value -- ; checks the slot's range"""
    INDEX = 6
    """INDEX low size stride: slot i -- slot + (i - low) * stride; error INDEX if i is outside [low, low + size)"""
    COPY = 7
    """COPY n: destination source -- ; copies n slots with range checks, safe for overlap"""
    EQUAL_SLOTS = 8
    """EQUAL_SLOTS n: slot slot -- 0|1"""
    RESET = 9
    """clock value -- ; sets a clock; error NEGATIVE_CLOCK if value < 0"""
    DUPLICATE = 10
    """a -- a a"""
    POP = 11
    """a --"""
    SWAP = 12
    """a b -- b a"""
    OVER = 13
    """a b -- a b a"""
    TABLE = 14
    """TABLE position low size: i -- the word of the code at position + i - low; error INDEX as for INDEX"""
    COPY_CLOCK = 15
    """clock clock -- ; sets the first clock to the value of the second"""
    ADVANCE_CLOCK = 16
    """clock value -- ; adds to a clock; error NEGATIVE_CLOCK if value < 0"""
    ADD = 20
    SUBTRACT = 21
    MULTIPLY = 22
    DIVIDE = 23
    """error DIVISION if the divisor is 0"""
    MODULO = 24
    POWER = 25
    """error NEGATIVE_EXPONENT if the exponent is negative"""
    BIT_AND = 26
    BIT_OR = 27
    BIT_XOR = 28
    SHIFT_LEFT = 29
    """error SHIFT if the distance is negative or above 31"""
    SHIFT_RIGHT = 30
    MINIMUM = 31
    MAXIMUM = 32
    NEGATE = 33
    NOT = 34
    """a -- 0|1"""
    BOOLEAN = 35
    """a -- (a != 0)"""
    EQUAL = 40
    NOT_EQUAL = 41
    LESS = 42
    LESS_EQUAL = 43
    GREATER = 44
    GREATER_EQUAL = 45
    JUMP = 50
    """JUMP position"""
    JUMP_IF_ZERO = 51
    """JUMP_IF_ZERO position: a --"""
    JUMP_IF_NONZERO = 52
    """JUMP_IF_NONZERO position: a --"""
    CALL = 53
    """CALL position: remembers where to go on"""
    RETURN = 54
    ASSERT = 55
    """a -- ; error ASSERT if a is 0"""
    CHECK_RANGE = 56
    """CHECK_RANGE low high: a -- a; error RANGE"""
    FLOATING = 57
    """FLOATING operation slot: a b -- c; a `tachk.model.floating.FloatingOperation` on the doubles whose first slots
    are a and b (one with a single argument takes a; FROM_INTEGER takes a itself). A double is stored
    from the slot on, which c is then; any other result is c; error NOT_FINITE"""

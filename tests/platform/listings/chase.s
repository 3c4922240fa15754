# PPE: follow pointers through L1.
loop:
        lwz     r3, 0(r3)
        bdnz    loop

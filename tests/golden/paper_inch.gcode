(linedrawd: 3 strokes)
F47.24
G00 Z-0.2
(stroke 0)
X1.18 Y1.57
G01 Z0
X1.18 Y1.99
X1.62 Y1.99
G00 Z-0.2
(stroke 1)
X1.97 Y1.18
G01 Z0
X2.36 Y1.18
X2.36 Y1.57
X1.97 Y1.57
X1.97 Y1.18
G00 Z-0.2
(stroke 2)
X0.49 Y0.00
G01 Z0
G00 Z-0.2
(no stroke)
M30

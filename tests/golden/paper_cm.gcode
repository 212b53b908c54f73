(linedrawd: 3 strokes)
F120.00
G00 Z-0.5
(stroke 0)
X3.00 Y4.00
G01 Z0
X3.00 Y5.05
X4.12 Y5.05
G00 Z-0.5
(stroke 1)
X5.00 Y3.00
G01 Z0
X6.00 Y3.00
X6.00 Y4.00
X5.00 Y4.00
X5.00 Y3.00
G00 Z-0.5
(stroke 2)
X1.23 Y0.00
G01 Z0
G00 Z-0.5
(no stroke)
M30

[Metadata]
Name: zoom
Focal Length: 60mm
Maximum F Number: 4.5
Patent: US 1
Squeeze: 1
[Elements]
100 4 1.52 20 64.1 SCHOTT_N_BK7 SPHERICAL
-80 30 1 20 AIR ASPHERICAL
0 2 1 6 0 AIR SPHERICAL
90 3 1.62 15 36.4 UNKNOWN SPHERICAL
0 50 1 15 0 AIR SPHERICAL
[Aspheric Coefficients]
1: k=-1.5 a4=2e-7 A6=0 a8=-1e-13
[Variable Distances]
Focal Length Samples: 60 70.5
1: 31 25
4: 48 53 # film

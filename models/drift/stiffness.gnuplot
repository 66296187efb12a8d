# The stiffness along the whole record, estimated and true. From the checkout, when the command of README.md has been run:
#   gnuplot models/drift/stiffness.gnuplot > models/drift/stiffness.svg
states = 'results/drift/wandering/states.csv'
true(x) = 200*(1 - 0.1/(1 + exp(-(x - 40)/0.2)))

set terminal svg size 760,330 dynamic noenhanced font 'Helvetica,12' name 'stiffness' background rgb '#ffffff'
set datafile separator ','
set datafile commentschars '#'
set border 3 lw 1 lc rgb '#66717d'
set tics nomirror out scale 0.6 textcolor rgb '#1f2933'
set grid back lt 1 lw 1 lc rgb '#e3e7ec'
set offsets 0,0,0,0
set lmargin at screen 0.11
set rmargin at screen 0.98
set tmargin at screen 0.88
set bmargin at screen 0.2
set key at screen 0.98, screen 0.98 right top horizontal samplen 2 textcolor rgb '#1f2933'
set xlabel 'time [s]' textcolor rgb '#1f2933'
set ylabel 'k [10³ N/m]' textcolor rgb '#1f2933'
set yrange [175:205]
set samples 2000
plot states using (column('t')):(1e-3*column('k_q2.5')):(1e-3*column('k_q97.5')) with filledcurves lc rgb '#a9c8e4' title '95 % band', \
     states using (column('t')):(1e-3*column('k_mean')) with lines lw 1.4 lc rgb '#1b5e9b' title 'mean', \
     true(x) with lines lw 1.2 lc rgb '#b4541a' title 'true'

# gnuplot -e "data='scaling.txt'; out='docs/figures/scaling.svg'" tests/benchmark/scaling.gnuplot
set terminal svg size 900,620 font "sans,12" background "white"
set output out
set multiplot layout 2,2
set grid lc rgb "#dddddd"
set key top left
set style line 1 lc rgb "#1f5fa8" lw 2 pt 7 ps 0.6
set style line 2 lc rgb "#c2571a" lw 2 pt 5 ps 0.6
set style line 3 lc rgb "#888888" lw 1 dt 2
set logscale xy
set xlabel "lanes"; set ylabel "µs a trajectory"
set xtics (4, 8, 16, 32, 64)
set xrange [3.5:75]; set yrange [0.1:30]
plot data index 0 using 1:2 with linespoints ls 1 title "interpreter", "" index 0 using 1:3 with linespoints ls 2 title "machine code"
set xlabel "samples"; set xrange [80:130000]; set xtics auto; set yrange [*:*]; set format x "10^{%L}"
plot data index 1 using 1:2 with linespoints ls 1 notitle, "" index 1 using 1:3 with linespoints ls 2 notitle
set xlabel "states (chain of masses, 500 samples)"; set format x "%g"; set xtics (2, 4, 8, 16, 32, 64); set xrange [1.8:75]
plot data index 2 using 1:2 with linespoints ls 1 notitle, "" index 2 using 1:3 with linespoints ls 2 notitle
unset logscale y; set xlabel "threads"; set ylabel "times as fast as one"; set xtics (1, 2, 4, 8, 16); set xrange [0.9:18]; set yrange [0:*]
plot data index 3 using 1:2 with linespoints ls 1 notitle
unset multiplot

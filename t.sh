run() { MOCURATE_CACHE=/tmp/jobs/cache_$1 /work/main/build/test/bin/mocurate run configs/reannotate/kard.yaml --to fitting -j $2 -o /tmp/jobs/$1 > /tmp/jobs/$1.log 2>&1; }
for k in a b c d; do MOCURATE_CACHE=/tmp/jobs/cache_$k build/test/bin/mocurate run configs/reannotate/kard.yaml --to proportions -o /tmp/jobs/$k >/dev/null 2>&1; done
s=$(date +%s.%N); run a 1; e=$(date +%s.%N); echo one $(echo "$e-$s"|bc)
s=$(date +%s.%N); run b 2; e=$(date +%s.%N); echo two $(echo "$e-$s"|bc)
s=$(date +%s.%N); run c 1 & run d 1 & wait; e=$(date +%s.%N); echo indep $(echo "$e-$s"|bc)

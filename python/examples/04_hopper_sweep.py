"""Four openings of a hopper in six lines. The same in a shell:

    tandem sweep hopper.json --set mouth=0.04:0.07:4 --of mouth.flow:mean:0.25:0.4 --jobs 2
"""
import tandem as td

s = td.load("hopper.json")
best = td.sweep(s, mouth=[.04, .05, .06, .07], score="mouth.flow:mean:0.25:0.4", jobs=2)
print(best.table())
best.picture("response.png")

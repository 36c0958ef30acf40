# What lies behind the response curves: the branches of orbits, and how every case ends. Runs that
# are classified give the orbits from which branches begin, so one job writes both.
rule branches:
    input:
        again=PLAN.again("branches"),
    output:
        PLACES.branches,
        PLACES.special_points,
        PLACES.mechanism("attractors"),
    log:
        PLACES.log("branches"),
    benchmark:
        PLACES.benchmark("branches")
    # This job takes longest, and the notebook waits for it.
    priority: 2
    params:
        made_of=PLAN.made_of("branches"),
    shell:
        'python -m gearmesh.pipeline branches "$STUDY" {params.made_of} 2>&1 | tee {log}'

// nextflow run main.nf --plan runs/kard/plan/fitting.json, after mocurate plan; one stage after the other
process runTask {
  errorStrategy { task.exitStatus == 75 ? 'retry' : 'finish' }
  maxRetries 2
  input: val k
  script: "mocurate run --plan '${file(params.plan, glob: false).toString().replace("'", "'\\''")}' --task $k"
}
workflow {
  tasks = new groovy.json.JsonSlurper().parse(file(params.plan, glob: false)).head.tasks
  if (tasks > 0) Channel.of(0..tasks - 1) | flatten | runTask
}

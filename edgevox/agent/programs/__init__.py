"""Small programs: orders that are repeated, delayed, or wait for a condition.

Templates alone, never a language model, turn sentences into programs (`agent.nlu.meaning`,
`agent.nlu.order_reader`). `store` bounds them and holds them, `keeper` starts and ends them, `run`
runs their steps on the goal runner.
"""

//! A virtual robot cabinet: tasks, motion queue, signals, sockets as a trait.

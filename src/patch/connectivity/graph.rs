//! A small directed graph: what can be reached, and which nodes can all reach each other.

/// Nodes 0 to n and their neighbours both ways, sorted.
pub(super) struct Graph {
    next: Vec<Vec<u32>>,
    previous: Vec<Vec<u32>>,
}

impl Graph {
    pub fn new(nodes: usize, edges: impl Iterator<Item = (u32, u32)>) -> Self {
        let mut graph = Self { next: vec![Vec::new(); nodes], previous: vec![Vec::new(); nodes] };
        for (a, b) in edges {
            graph.next[a as usize].push(b);
            graph.previous[b as usize].push(a);
        }
        for neighbours in graph.next.iter_mut().chain(&mut graph.previous) {
            neighbours.sort_unstable();
            neighbours.dedup();
        }
        graph
    }

    pub fn next(&self, node: u32) -> &[u32] {
        &self.next[node as usize]
    }

    pub fn previous(&self, node: u32) -> &[u32] {
        &self.previous[node as usize]
    }

    /// What can be reached from `start`, itself included.
    pub fn ahead(&self, start: impl Iterator<Item = u32>) -> Vec<bool> {
        reach(&self.next, start)
    }

    /// From where `goal` can be reached, itself included.
    pub fn behind(&self, goal: impl Iterator<Item = u32>) -> Vec<bool> {
        reach(&self.previous, goal)
    }

    /// The strongly connected components, each sorted; edges lead from earlier to later ones. O(nodes + edges).
    ///
    /// Kosaraju's algorithm: searched backwards in the reverse order of leaving, every search stays in one component.
    pub fn components(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.next.len()];
        let mut components = Vec::new();
        for &node in self.order_of_leaving().iter().rev() {
            let mut component = Vec::new();
            let mut open = vec![node];
            while let Some(n) = open.pop() {
                if !std::mem::replace(&mut seen[n as usize], true) {
                    component.push(n);
                    open.extend(self.previous(n));
                }
            }
            component.sort_unstable();
            components.push(component);
        }
        components.retain(|c| !c.is_empty());
        components
    }

    /// The nodes in the order in which a depth-first search leaves them.
    fn order_of_leaving(&self) -> Vec<u32> {
        let mut seen = vec![false; self.next.len()];
        let mut left = Vec::with_capacity(self.next.len());
        for start in 0..self.next.len() as u32 {
            let mut open = vec![(start, false)];
            while let Some((n, leaving)) = open.pop() {
                if leaving {
                    left.push(n);
                } else if !std::mem::replace(&mut seen[n as usize], true) {
                    open.push((n, true));
                    open.extend(self.next(n).iter().map(|&m| (m, false)));
                }
            }
        }
        left
    }
}

fn reach(next: &[Vec<u32>], start: impl Iterator<Item = u32>) -> Vec<bool> {
    let mut seen = vec![false; next.len()];
    let mut open: Vec<u32> = start.collect();
    while let Some(n) = open.pop() {
        if !std::mem::replace(&mut seen[n as usize], true) {
            open.extend(&next[n as usize]);
        }
    }
    seen
}

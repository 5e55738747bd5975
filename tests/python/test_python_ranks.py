"""Ranks: several agents of a process each with a part of the worlds learn the bytes of one with all of them; a hook that fails ends
the call."""
import pickle
import threading
import unittest

import numpy as np

import redman

TASK, OPTIONS = "ball_run", {"horizon": 16, "blocks": 4}


class Exchange:
    """Messages between threads, as comm.allgather of mpi4py between processes."""

    def __init__(self, ranks):
        self.barrier, self.all = threading.Barrier(ranks, timeout=60), [b""] * ranks

    def gather(self, rank):
        def hook(message):
            self.all[rank] = message
            self.barrier.wait()
            out = list(self.all)
            self.barrier.wait()
            return out
        return hook

    def swap(self, rank):
        gather = self.gather(rank)
        return lambda partner, message: gather(message)[partner]


def learned(ranks, num_envs, results, epochs=3):
    with redman.Pool(TASK, num_envs, seed=3, ranks=ranks) as pool, redman.Agent(pool, seed=1, options=OPTIONS, ranks=ranks) as agent:
        pool.reset()
        for _ in range(epochs):
            epoch = agent.rollout(pool)
        results[0 if ranks is None else ranks.rank] = epoch, bytes(agent.policy()), pool.obs.copy()


def together(ranks, swaps):
    exchange, results = Exchange(ranks), {}
    threads = [threading.Thread(target=learned, args=(
        redman.Ranks(k, ranks, exchange.gather(k), exchange.swap(k) if swaps else None), 4 // ranks, results)) for k in range(ranks)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return results


class Together(unittest.TestCase):
    def test_they_learn_what_one_learns_to_the_byte(self):
        alone = {}
        learned(None, 4, alone)
        for swaps in (False, True):
            results = together(2, swaps)
            self.assertEqual(len(results), 2)
            for rank in range(2):
                self.assertEqual(repr(results[rank][0]), repr(alone[0][0]))
                self.assertEqual(results[rank][1], alone[0][1])
            self.assertTrue(np.array_equal(np.concatenate([results[k][2] for k in range(2)]), alone[0][2]))

    def test_one_rank_needs_no_messages(self):
        alone, single = {}, {}
        learned(None, 4, alone)
        learned(redman.Ranks(0, 1), 4, single)
        self.assertEqual(single[0][1], alone[0][1])

    def test_what_a_hook_raises_ends_the_call(self):
        def broken(message):
            raise OSError("the line is cut")
        for hook, words in ((broken, "gather raised OSError: the line is cut"), (lambda message: [message, b""], "bytes, but must return 2 of")):
            ranks = redman.Ranks(0, 2, hook)
            pool = redman.Pool(TASK, 2, ranks=ranks)
            pool.reset()
            agent = redman.Agent(pool, options=OPTIONS, ranks=ranks)
            with self.assertRaisesRegex(redman.CancelledError, words) as caught:
                agent.rollout(pool)
            self.assertIsNotNone(caught.exception.__cause__)

    def test_errors_say_what_may_be(self):
        with self.assertRaisesRegex(redman.ArgumentError, "rank: 2 is not between 0 and 1"):
            redman.Ranks(2, 2, lambda message: [message])
        with self.assertRaisesRegex(redman.UsageError, "comm.allgather"):
            redman.Ranks(0, 2)
        with self.assertRaisesRegex(redman.UsageError, "one process"):
            pickle.dumps(redman.Ranks(0, 1))


if __name__ == "__main__":
    unittest.main()

"""Whether Python's memory grows while something is done again and again."""
import gc
import tracemalloc


def grown(act, times=1000):
    """Bytes of Python's objects that are more after `times` calls of act than after as many before."""
    def some():
        for _ in range(times):
            act()
    tracemalloc.start()
    try:
        some()  # fills what the interpreter keeps of freed objects
        gc.collect()
        begin = tracemalloc.get_traced_memory()[0]
        some()
        return tracemalloc.get_traced_memory()[0] - begin
    finally:
        tracemalloc.stop()

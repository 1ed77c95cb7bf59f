"""The score of a sweep: words of results, or a function of them."""
from typing import Any, Callable, Dict, List, Sequence, Union

from tandem.entries import SceneError
from tandem.reductions import expect_reduction

Score = Union[str, Sequence[str], Callable[[Any], Any], None]


def expect_words(score: Score, end_time: Any) -> None:
    """Refuses wrong reductions before anything runs."""
    if not (score is None or isinstance(score, str) or callable(score) or (isinstance(score, (list, tuple)) and all(isinstance(of, str) for of in score))):
        raise SceneError(f"it is {score!r}", "score", 'give "COLUMN:REDUCTION", a list of these, or a function of the results')
    for of in _words(score):
        try:
            expect_reduction(of, end_time if isinstance(end_time, (int, float)) else None)
        except SceneError as error:  # said of the command line
            raise SceneError(error.what, f"score {of}", error.hint) from None


def score_of(score: Score, same_columns: bool) -> Callable[[Any], Dict[str, float]]:
    """Numbers of results. With `same_columns` a name that one variant does not have is wrong for all, and ends the sweep."""
    if callable(score):
        def call(results: Any) -> Dict[str, float]:
            value = score(results)
            return {k: float(v) for k, v in value.items()} if isinstance(value, dict) else {"score": float(value)}
        return call

    def numbers(results: Any) -> Dict[str, float]:
        try:
            return {of: results.reduce(of) for of in _words(score)}
        except KeyError as error:
            if not same_columns:
                raise
            raise SceneError(str(error.args[0]), "score", "what has run is kept") from None
    return numbers


def _words(score: Score) -> List[str]:
    return [score] if isinstance(score, str) else [] if score is None or callable(score) else list(score)

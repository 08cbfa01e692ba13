# SPDX-License-Identifier: Apache-2.0
from typing import Any, Callable, Dict, List, Optional, Tuple

from ._arrays import Array

version: str
unnamed: str
unnamed_family: str
has_judges: bool

def list_members(path: str) -> List[str]: ...
def model_names() -> List[str]: ...
def sampler_file_material(path: str) -> str: ...
def names_family(text: str) -> bool: ...

class Brdf:
    name: str
    channels: int
    has_channel_axis: bool
    is_function: bool
    calls: Tuple[int, int]
    @staticmethod
    def from_text(text: str, beside: str) -> Brdf: ...
    @staticmethod
    def from_file(path: str, member: str) -> Brdf: ...
    @staticmethod
    def from_function(function: Any, name: str, double_precision: bool) -> Brdf: ...
    def eval(self, wo: Array, wi: Array, out: Array, cosine: bool) -> None: ...

class Sampler:
    brdf: Brdf
    report: Dict[str, Any]
    material: str
    domain: str
    half_square: bool
    isotropic: bool
    nbytes: int
    slabs: Tuple[int, int]
    leaf_counts: Tuple[int, int]
    @staticmethod
    def build(
        brdf: Brdf,
        *,
        target: str,
        channel: int,
        expected_trials: float,
        one_shot_variance: float,
        albedo_error: float,
        seed: int,
        max_evaluations: int,
        threads: int,
        progress: Optional[Callable[[float, str], Any]],
    ) -> Sampler: ...
    @staticmethod
    def from_bytes(brdf: Brdf, bytes: bytes, where: str) -> Sampler: ...
    @staticmethod
    def from_file(brdf: Brdf, path: str) -> Sampler: ...
    def to_bytes(self) -> bytes: ...
    def save(self, path: str) -> None: ...
    def sample(
        self,
        one_shot: bool,
        wo: Array,
        u: Optional[Array],
        seed: int,
        stream: int,
        wi: Array,
        pdf: Array,
        weight: Array,
        valid: Array,
    ) -> None: ...
    def sample_n(
        self,
        one_shot: bool,
        wo: Array,
        seed: int,
        stream: int,
        wi: Array,
        pdf: Array,
        weight: Array,
        valid: Array,
    ) -> None: ...
    def eval_pdf(
        self,
        one_shot: bool,
        wo: Array,
        wi: Array,
        f: Optional[Array],
        pdf: Optional[Array],
        cosine: bool,
    ) -> None: ...
    def invert(self, wo: Array, wi: Array, out: Array) -> None: ...
    def albedo(self, wo: Array, out: Array) -> None: ...
    def expected_trials(self, wo: Array, out: Array) -> None: ...
    def tables(self, one_shot: bool) -> Dict[str, Any]: ...
    def draw_one(self, wo: List[float], u1: float, u2: float) -> List[float]: ...
    def density_one(self, wo: List[float], wi: List[float]) -> float: ...
    def leaves(self, one_shot: bool, x: float, y: float, z: float) -> List[Any]: ...

class Family:
    name: str
    domain: str
    isotropic: bool
    channels: int
    has_channel_axis: bool
    ranges: Dict[str, Tuple[float, float]]
    report: Dict[str, Any]
    nbytes: int
    leaf_counts: Tuple[int, int]
    @staticmethod
    def build(
        text: str,
        *,
        target: str,
        channel: int,
        expected_trials: float,
        one_shot_variance: float,
        albedo_error: float,
        seed: int,
        max_evaluations: int,
        threads: int,
        progress: Optional[Callable[[float, str], Any]],
    ) -> Family: ...
    @staticmethod
    def build_function(
        function: Any,
        name: str,
        double_precision: bool,
        ranges: List[Tuple[str, float, float]],
        *,
        target: str,
        channel: int,
        expected_trials: float,
        one_shot_variance: float,
        albedo_error: float,
        seed: int,
        max_evaluations: int,
        threads: int,
        progress: Optional[Callable[[float, str], Any]],
    ) -> Family: ...
    @staticmethod
    def from_file(path: str, function: Any, name: str, double_precision: bool) -> Family: ...
    @staticmethod
    def from_bytes(bytes: bytes, where: str, function: Any, name: str, double_precision: bool) -> Family: ...
    def to_bytes(self) -> bytes: ...
    def save(self, path: str) -> None: ...
    def sample(
        self,
        one_shot: bool,
        wo: Array,
        parameters: Array,
        u: Optional[Array],
        seed: int,
        stream: int,
        wi: Array,
        pdf: Array,
        weight: Array,
        valid: Array,
    ) -> None: ...
    def eval_pdf(
        self,
        one_shot: bool,
        wo: Array,
        wi: Array,
        parameters: Array,
        f: Optional[Array],
        pdf: Optional[Array],
        cosine: bool,
    ) -> None: ...
    def albedo(self, wo: Array, parameters: Array, out: Array) -> None: ...
    def expected_trials(self, wo: Array, parameters: Array, out: Array) -> None: ...
    def member(self, parameters: List[float]) -> Sampler: ...
    def tables(self, one_shot: bool) -> Dict[str, Any]: ...
    def member_of(self, brdf: Brdf, parameters: List[float]) -> Sampler: ...

# Where has_judges is true.

class Diagnosis:
    subject: str
    conventions: List[str]
    healthy: bool
    checks: List[Any]
    findings: List[Any]
    figures: List[Any]

def verify(
    sampler: Sampler,
    *,
    effort: float,
    seed: int,
    threads: int,
    progress: Optional[Callable[[float, str], Any]],
) -> Dict[str, Any]: ...
def diagnose_functions(
    eval: Callable[[Array, Array], Array],
    sample: Callable[[Array, int], Array],
    pdf: Optional[Callable[[Array, Array], Array]],
    *,
    channels: int,
    name: str,
    eval_returns: str,
    sample_returns: str,
    effort: str,
    seed: int,
    progress: Optional[Callable[[float, str], Any]],
) -> Tuple[Diagnosis, int, int]: ...
def diagnose_sampler(
    sampler: Sampler,
    *,
    mode: str,
    name: str,
    effort: str,
    seed: int,
    threads: int,
    progress: Optional[Callable[[float, str], Any]],
) -> Diagnosis: ...
def diagnose_peer(
    brdf: Brdf,
    *,
    sampler: str,
    name: str,
    effort: str,
    seed: int,
    threads: int,
    progress: Optional[Callable[[float, str], Any]],
) -> Diagnosis: ...
def doctor_causes() -> Dict[str, str]: ...
def sampler_names() -> Dict[str, str]: ...

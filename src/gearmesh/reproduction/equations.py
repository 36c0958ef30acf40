"""The paper's equations (1) to (7), in LaTeX, and as MathML that needs no script to be shown."""

from dataclasses import dataclass

from latex2mathml.converter import convert


@dataclass(frozen=True, slots=True)
class Equation:
    """One numbered equation of the paper.

    Attributes
    ----------
    number : int
        Its number in the paper.
    name : str
        What it states.
    latex : tuple of str
        The equation, in lines.
    reading : str
        How the model interprets it, in one or two sentences.
    """

    number: int
    name: str
    latex: tuple[str, ...]
    reading: str

    @property
    def mathml(self) -> list[str]:
        """The lines of the equation as MathML."""
        return [convert(line, display="block") for line in self.latex]


EQUATIONS = (
    Equation(
        1,
        "Motion",
        (
            r"\mathbf{M}\mathbf{v}''+{}_{1}\mathbf{K}(\beta,\delta_i,H)\,\mathbf{v}'"
            r"+\sum_{K_1>1}{}_{K_1}\mathbf{K}(D,D_i,H)\,|\mathbf{w}'(\mathbf{v}')|^{K_1}"
            r"\operatorname{sgn}(\mathbf{w}'(\mathbf{v}'))",
            r"+{}_{1}\mathbf{C}(\varepsilon,\kappa,Y_n,U_n,V_n,H,\tau)\,\mathbf{v}"
            r"+\sum_{K>1}{}_{K}\mathbf{C}(\varepsilon,\kappa,I_n,H,\tau)\,\mathbf{w}^{K}(\mathbf{v})"
            r"=\mathbf{F}(a_n,b_n,\bar\varphi,H,\tau)",
        ),
        "Six coordinates: the rotations φ_3 and φ_2 and the displacements y_3, y_2, z_3 and z_2. "
        "The elastic force in the mesh is linear in each region, so C has only its "
        "first term.",
    ),
    Equation(
        2,
        "Dynamic force",
        (r"F_{\mathrm{dyn}}=C(\tau)\,y(\tau)",),
        "Taken as printed: it is the elastic force in normal mesh only.",
    ),
    Equation(
        3,
        "Relative motion",
        (
            r"y(\tau)=R_{b3}\varphi_3+R_{b2}\varphi_2+y_3-y_2+e_3\,\sin\,\varphi_3"
            r"-e_2\,\sin(\Delta-\varphi_2)+{}^{1,2}f(\tau)",
        ),
        "Normal mesh for y ≥ 0, contact loss for −s < y < 0, inverse mesh for y ≤ −s. The "
        "sines contain the whole rotation of the wheel, not only its vibration.",
    ),
    Equation(
        4,
        "Mesh stiffness",
        (
            r"C(t)=C_s+\frac{C_{\mathrm{max}}(1-\kappa)}{2}\sum_{n=1}^{\infty}\frac{4}{\pi n}(-1)^n"
            r"\,\sin\,n[(\varepsilon-2)\pi]\,\cos\,n\omega_c t",
        ),
        "The sum is a rectangular wave: C_max while two pairs of teeth are in mesh, C_min "
        "while one is. Steps of the integration end at its switches.",
    ),
    Equation(
        5,
        "Mean stiffness",
        (
            r"C_s=\kappa C_{\mathrm{max}}+\frac{C_{\mathrm{max}}(1-\kappa)}{2}"
            r"[1+(2\varepsilon-3)]",
        ),
        "It defines the mesh frequency ν_s = ω_c/Ω_s, with Ω_s² = C_s/m_red.",
    ),
    Equation(
        6,
        "Friction",
        (
            r"F_T(t)=-f_T\{y(t)H_1+[y(t)+s(t)]H_2\}\,C(t)\,\gamma(t)",
            r"\times\operatorname{sign}\{\delta^{0}_{e_2+e_3}+[e_3\dot\varphi_3\,\sin\,\varphi_3"
            r"-e_2\dot\varphi_2\,\sin(\Delta-\varphi_2)]\}\,"
            r"\operatorname{sign}[\delta^{0}_{e_2+e_3}+(\dot z_3-\dot z_2)]",
        ),
        "Over all pairs in mesh γ is 0 in double contact, and 1, then −1 in single contact. "
        "Without eccentricity both signs are 1.",
    ),
    Equation(
        7,
        "Damping",
        (
            r"{}_{1}\mathbf{K}(\beta,\delta_i,H)\,\mathbf{v}'+\sum_{K_1>1}{}_{K_1}\mathbf{K}(D,D_i,H)"
            r"\,|\mathbf{w}'(\mathbf{v}')|^{K_1}\operatorname{sgn}(\mathbf{w}'(\mathbf{v}'))"
            r"\quad\text{for}\ K_1=2,3",
        ),
        "In the mesh: k_1 y′ + k_2 |y′| y′/v_ref + k_3 y′³/v_ref², with the coefficients of the "
        "material in normal and inverse mesh and those of the lubricant in contact loss.",
    ),
)
"""All numbered equations, in the paper's order."""
